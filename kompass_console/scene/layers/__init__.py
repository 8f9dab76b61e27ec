"""What is drawn, one file per layer, and the shapes and colours that they share.

A layer converts what the robot said into a drawing once, on the scene's own thread; each page's
nodes are then updated from it on viser's loop. Nodes belong to one page, so a layer that is
hidden costs nothing, each page has its own theme, and nothing accumulates on the server.
"""
