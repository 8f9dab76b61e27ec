"""What every component is made of: declaration, lifecycle, inputs, status, services."""
