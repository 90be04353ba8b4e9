"""Carry out a specification as discrete events in simulated time; knows nothing of ASP."""

from mars_asp.execute.behaviour import Behaviour
from mars_asp.execute.executor import Executor
from mars_asp.execute.link import Link, Message
from mars_asp.execute.schedule import Schedule, tick_time

__all__ = ["Behaviour", "Executor", "Link", "Message", "Schedule", "tick_time"]
