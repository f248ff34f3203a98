"""Reading a sweep: pictures, a surface through its rows, what its parameters have to say, and a page of all that.

values        one output over the rows, in the unit that suits it, and which rows have none
axes          a parameter along an axis: numbers, or texts beside each other; what belongs to one grid
curves        an output against a parameter
histories     an output over time, coloured by a parameter
maps          an output over two parameters
plot          what of these to draw, on panels of one figure
surface       a response surface through rows, and how far it is off
sensitivities Sobol indices
page          the whole sweep as one page

They ask of a sweep what `values.Table` says, and know nothing of files.
"""
