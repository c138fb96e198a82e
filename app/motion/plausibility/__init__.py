"""What cannot be a human body, or is doubtful in one."""
