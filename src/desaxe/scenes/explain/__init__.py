"""`explain`: the plan of a scene before it runs, as a database explains a query.

explain   the plan of a scene, as data
costs     operations of each pass and loop, what was skipped and why, how often loads are looked up
plan_text the plan as sections of texts and tables
"""
