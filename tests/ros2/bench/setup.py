from setuptools import setup
from glob import glob

package_name = "bench"
setup(
    name=package_name,
    entry_points={
        "console_scripts": [
            "driver = bench.driver:main",
            "helper = " + package_name + ".helper:main",
            f"worker = {package_name}.worker:main",
            "legacy = bench.legacy:main",
                "wheels = bench.wheels:main",
        ]
    },
)
