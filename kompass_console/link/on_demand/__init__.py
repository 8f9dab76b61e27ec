"""What is read from the graph only while somebody looks at it: further layers, and cameras."""
