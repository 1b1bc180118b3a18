"""Accuracy and time of desaxe, measured against an independent reference."""
