"""A fitted model handed on to another simulator, as the text of a model file: knows systems and nothing of records or fits."""

from .carried import TARGETS as TARGETS
from .carried import exported as exported
