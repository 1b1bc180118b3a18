"""`explain`: the plan of a scene before it runs, as a database explains a query.

explain   the plan of a scene, as data
steps     what was skipped and why, and what each pass saved
loops     operations per loop of a kernel
loads     how often a load is looked up, and where
plan_text the plan as sections of texts and tables
"""
