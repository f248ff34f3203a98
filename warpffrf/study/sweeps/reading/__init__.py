"""Evaluation of a sweep: pictures, response surface, sensitivities, and a page of all these.

values        one output over the rows, in a suitable unit, and rows without a value
plot          an output against a parameter, over time, over two parameters: panels of one figure
surface       a response surface through rows, and its error
sensitivities Sobol indices
page          the whole sweep as one page

They use the interface `values.Table` of a sweep, and do not access files.
"""
