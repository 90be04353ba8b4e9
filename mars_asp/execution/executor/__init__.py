"""Execution of a specification as discrete events in simulated time, without ASP."""

from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.executor import Executor
from mars_asp.execution.executor.link import Link, Message
from mars_asp.execution.executor.schedule import Schedule, tick_time

__all__ = ["Behaviour", "Executor", "Link", "Message", "Schedule", "tick_time"]
