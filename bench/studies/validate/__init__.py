"""Verification: every published or closed-form case, compared by one command; a quarter of an hour.

FOLDER/verification.md      the page: one table of all cases, what misses its tolerance, what is not compared
FOLDER/verification.json    the same figures

`python -m studies validate NAME ...` runs single cases, prints their rows and writes nothing.
"""

from studies.validate import bearings as bearings
from studies.validate import bodies as bodies
from studies.validate import contact as contact
from studies.validate import films as films
from studies.validate import friction as friction
from studies.validate import gears as gears
from studies.validate import impact as impact
from studies.validate import joints as joints
from studies.validate import mechanisms as mechanisms
from studies.validate import responses as responses
from studies.validate import structures as structures
from studies.validate.case import CASES as CASES
from studies.validate.page import write as write
