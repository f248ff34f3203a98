"""Reading a sweep: pictures, a surface through its rows, what its parameters have to say, and a page of all that.

values        one output over the rows, in the unit that suits it, and which rows have none
plot          an output against a parameter, over time, over two parameters: panels of one figure
surface       a response surface through rows, and how far it is off
sensitivities Sobol indices
page          the whole sweep as one page

They ask of a sweep what `values.Table` says, and know nothing of files.
"""
