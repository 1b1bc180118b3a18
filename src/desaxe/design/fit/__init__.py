"""The parameters of a machine from measurements.

fit         the public call
data        measurements: mappings, tables, labelled arrays, CSV files
unknowns    parameters and nuisances: starts, bounds, scales
model       residuals and their exact Jacobian
solve       the search from several starts
spread      covariance, the directions that the data leave open, and the scaled gradient
result      what was found: numbers, prediction bands, report, plot
"""
