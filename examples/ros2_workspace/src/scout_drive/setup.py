from glob import glob

from setuptools import find_packages, setup

package_name = "scout_drive"

setup(
    name=package_name,
    version="1.0.0",
    packages=find_packages(),
    data_files=[
        (f"share/{package_name}", ["package.xml"]),
        (f"share/{package_name}/config", glob("config/*.yaml")),
        (f"share/{package_name}/launch", glob("launch/*.launch.py")),
    ],
    entry_points={
        "console_scripts": [
            "patrol = scout_drive.patrol:main",
            "follow = scout_drive.follow:main",
            "dock = scout_drive.dock:main",
        ],
    },
)
