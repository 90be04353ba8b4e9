from setuptools import setup

setup(
    name="courier",
    entry_points={
        "console_scripts": [
            "base = courier.base:main",
            "camera = courier.camera:main",
            "patrol = courier.patrol:main",
            "viewer = courier.viewer:main",
        ]
    },
)
