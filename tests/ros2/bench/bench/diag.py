from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import Bool


class Diag:
    def __init__(self, node, robot):
        self.node = node
        self.pub = self.node.create_publisher(Bool, "diag_ok", 1)
        self.node.create_timer(1.0, self.tick)

    def tick(self):
        self.pub.publish(Bool())
