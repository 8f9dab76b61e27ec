"""Whether rules fit the messages, components and functions that they speak of."""
