from setuptools import find_packages, setup

package_name = "scout_drive"

setup(
    name=package_name,
    version="1.0.0",
    packages=find_packages(),
    entry_points={
        "console_scripts": [
            "patrol = scout_drive.patrol:main",
            "follow = scout_drive.follow:main",
            "dock = scout_drive.dock:main",
        ],
    },
)
