"""Accuracy and time of desaxe, measured against an independent reference.

command     `python -m benchmarks --accuracy`: measure, print, write the page
run         the audit: times and errors, family by family
contenders  every accuracy of desaxe, and other tools
times       time per point, alternating, on one core
errors      errors against the oracle, in shares of the promise and in ulp
report      the result as Markdown
picture     the result as a picture
freeze      the truths that `desaxe doctor --accuracy` compares with
"""
