from glob import glob

from setuptools import find_packages, setup

package_name = 'thrust_allocator'

# Run-time dependencies from PyPI that a ROS 2 Jazzy installation brings along itself
jazzy = ['ros-jazzy-rclpy[fastrtps]', 'ros-jazzy-common-interfaces']

setup(
    name=package_name,
    version='0.2.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={f'{package_name}.benchmark.published': ['*.csv']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml']),
        (f'share/{package_name}/config', glob('config/*.yaml')),
        (f'lib/{package_name}', glob('resource/executables/*')),  # where `ros2 run` looks for them
    ],
    python_requires='>=3.10',
    # SciPy, whose matrices OSQP takes, and joblib come with osqp
    install_requires=['setuptools', 'numpy', 'osqp>=1.1', 'PyYAML'],
    extras_require={
        'jazzy': jazzy,
        'test': ['pytest', 'hypothesis', 'daqp', 'matplotlib', 'dask[distributed]', 'flake8',
                 'pytest-xdist', 'rosbags'],
        'plot': ['matplotlib'],
        'replay': ['rosbags', 'matplotlib'],
        'cluster': ['dask[distributed]'],
        'bench': ['daqp', 'quadprog', 'casadi', 'matplotlib'],
    },
    zip_safe=True,
    maintainer='thrust_allocator maintainers',
    maintainer_email='maintainers@thrust-allocator.example',
    description='Thrust allocation for AUVs and ROVs with bounds that move with the speed',
    license='Apache-2.0',
    entry_points={
        'console_scripts': ['thrust_allocator = thrust_allocator.__main__:main'],
    },
)
