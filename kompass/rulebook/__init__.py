"""What people and programs say of a rule table: views, diffs, reports. Data only.

The monitor answers with these models as JSON, the command line prints them, the console's HTTP API
hands them on, and the page is typed against their schema: one definition for all four.
"""
