"""`explain`: the plan of a scene before it runs, as a database explains a query.

explain   the plan as data: operations of each pass and loop, what was skipped and why, cost
plan_text the plan as sections of texts and tables
"""
