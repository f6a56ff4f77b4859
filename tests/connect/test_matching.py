"""Which topic of a small robot is taken for an input, which are listed, and why one is not."""

import pytest

from eddi_scaffold.connect.matching import Decision, Fulfilment, decide
from eddi_scaffold.connect.topics import InputNeed, RobotTopic
from eddi_scaffold.monitors.message_types import known_messages
from tests.data_files import tabled

ROBOT = {
    "odom": ("nav_msgs/Odometry", "/odom"),
    "cmd_vel": ("geometry_msgs/Twist", "/cmd_vel"),
    "scan_front": ("sensor_msgs/LaserScan", "/laser_front/scan"),
    "scan_rear": ("sensor_msgs/LaserScan", "/laser_rear/scan"),
    "front_standby": ("std_msgs/Bool", "/laser_front/standby"),
    "gripper_closed": ("std_msgs/Bool", "/gripper/closed"),
    "link_lost": ("std_msgs/Bool", "/radio/link_lost"),
    "battery": ("sensor_msgs/BatteryState", "/battery"),
    "temperature": ("sensor_msgs/Temperature", "/motor/temperature"),
    "joints": ("sensor_msgs/JointState", "/arm/joint_states"),
    "pose": ("geometry_msgs/PoseWithCovarianceStamped", "/amcl_pose"),
    "features": ("std_msgs/Float32MultiArray", "/camera/features"),
    "guarantees": ("eddi_messages/ConSertOutput", "/other/guarantees"),
    "gone": ("gone_msgs/Marker", "/camera/marker"),
}
TOPICS = [RobotTopic(name, *rest) for name, rest in ROBOT.items()]


def decided(need: InputNeed, offers: list[Fulfilment] | None = None) -> Decision:
    given = {need.id: offers} if offers is not None else {}
    (decision,) = decide([need], TOPICS, known_messages().get, given)
    return decision


@tabled
def test_what_is_clear_is_taken(id_, type_, unit, topic, key, text, given):
    decision = decided(InputNeed(id_, type_, unit=unit))  # type: ignore[arg-type]
    best = decision.candidates[0]
    assert (decision.state, best.topic.id, best.access.key) == ("taken", topic, key)
    assert best.access.text.startswith(text)
    assert best.access.unit == given


@pytest.mark.parametrize(
    ("need", "listed", "text"),
    [
        (InputNeed("ArmJointPosition", "float", unit="rad"), "joints", "position[TODO]"),
        (InputNeed("PoseUncertainty", "float", unit="m"), "pose", "SQRT(pose.pose.covariance[0])"),
        (
            InputNeed("ObstacleDistance", "float", unit="m"),
            "scan_front",
            "MIN(scan_front",
        ),
        (InputNeed("ClimbSpeed", "float", unit="m/s"), "odom", "twist.twist.linear.z"),
        (InputNeed("RadioLink", "bool"), "link_lost", "data"),
        (InputNeed("MarkerVisible", "bool"), "gone", "TODO"),
        (InputNeed("FrontScanMatch", "float"), "scan_front", "ranges[TODO]"),  # no distance
        (InputNeed("PowerHolds", "bool"), "battery", "present"),  # says nothing of its power
        (InputNeed("CpuHeat", "float", unit="degC"), "temperature", "temperature"),  # of the motor
        (
            InputNeed("DistanceToRearGoal", "float", unit="m"),
            "scan_rear",
            "MIN(scan_rear",
        ),
        (InputNeed("Demand", "bool", is_demand=True), "guarantees", "guarantees[TODO].active"),
    ],
)
def test_what_is_not_clear_is_left_to_a_person(need: InputNeed, listed: str, text: str) -> None:
    decision = decided(need)
    assert decision.state == "listed"
    found = {one.topic.id: one.access.text for one in decision.candidates}
    assert found[listed].startswith(text)


@pytest.mark.parametrize(
    ("need", "topic", "why"),
    [
        (InputNeed("GripperClosed", "float"), "gripper_closed", "it is a bool"),
        (InputNeed("MotorTemperature", "float", unit="Pa"), "temperature", "it is in degC"),
    ],
)
def test_the_nearest_miss_is_named(need: InputNeed, topic: str, why: str) -> None:
    (decision,) = decide([need], [one for one in TOPICS if one.id == topic], known_messages().get)
    missed = decision.missed
    assert missed is not None
    assert (missed.topic.id, missed.reasons) == (topic, (why,))


def test_claims_of_other_names_are_listed_only_where_none_is_like_the_input() -> None:
    offers = [
        Fulfilment(TOPICS[-2], f"evidence[{key}].active", "", key, is_sure=False)
        for key in ("PoseIsGood", "LastsTheShift")
    ]
    for name, keys in {"PoseKnown": ["PoseIsGood"], "Zzz": ["PoseIsGood", "LastsTheShift"]}.items():
        found = decided(InputNeed(name, "bool"), offers)
        assert [one.access.text for one in found.candidates] == [
            f"evidence[{k}].active" for k in keys
        ]
