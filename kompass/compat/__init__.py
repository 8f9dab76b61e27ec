"""What recipes of older generations expect, and today's packages no longer do."""
