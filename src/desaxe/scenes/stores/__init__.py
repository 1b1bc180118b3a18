"""Files and stores of a scene, and the places where they go.

places       what a run needs and where it writes, looked at before it computes
files        NetCDF, Zarr, CSV, xlsx, npz
tables       a labelled result as rows, units in the headings
workbook     sheets of an .xlsx file
"""
