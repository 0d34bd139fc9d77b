"""The study: what moving bounds are worth to a vehicle, in pictures and tables, without ROS."""
