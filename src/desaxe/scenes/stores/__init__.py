"""Files and stores of a scene.

files   NetCDF, Zarr, CSV, xlsx, npz; what a run needs and where it writes, looked at before it computes
tables  results as rows, units in the headings; workbooks of them
"""
