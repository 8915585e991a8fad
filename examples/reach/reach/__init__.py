"""A kind of scenario: come to rest anywhere within a ball. Importing it registers what each room asks of a scenario."""

from reach import certificate, picture, problem
from reach.scenario import Reach

__all__ = ["Reach", "certificate", "picture", "problem"]
