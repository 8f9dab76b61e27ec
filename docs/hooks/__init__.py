"""Makes the pages of the documentation that come from the code. Nothing of it is committed."""
