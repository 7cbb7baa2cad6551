"""A ROS 2 node that relays to a robot, which runs with ``sarah-robot --real-time --listen``. It was never run with ROS.

One sees the robot's telemetry as text on /sarah/telemetry, and answers to nine numbers on /sarah/parameters.
"""

import sys
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray, String

from sarah.errors import SarahError
from sarah.operation.settings import BOX
from sarah.remote.client import Client
from sarah.remote.endpoints import TELEMETRY, Endpoint
from sarah.remote.requests import Request


def push(values: list[float]) -> None:
    """Push P1 to P5 and V1 to V4, and log the answers."""
    try:
        with Client(endpoint) as robot:
            for answer in robot.ask(Request("push", dict(zip(BOX.names, values, strict=False)))):
                node.get_logger().info(f"{answer.outcome.value} at tick {answer.tick} {answer.reason}")
    except SarahError as error:
        node.get_logger().error(str(error))


rclpy.init()
node, endpoint = Node("sarah_relay"), Endpoint(sys.argv[1]) if sys.argv[1:] else Endpoint()
session = endpoint.opened(listens=False)
topic = node.create_publisher(String, "/sarah/telemetry", 10)
relay = session.declare_subscriber(TELEMETRY, lambda sample: topic.publish(String(data=sample.payload.to_string())))
start = lambda message: threading.Thread(target=push, args=(list(message.data),)).start()  # noqa: E731
node.create_subscription(Float64MultiArray, "/sarah/parameters", start, 10)
try:
    rclpy.spin(node)
finally:
    session.close()
