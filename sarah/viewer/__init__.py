"""The page in the browser that shows the robot and plays episodes (the extra ``view``)."""
