"""The table in force, its revisions, and everything that changes or checks one."""
