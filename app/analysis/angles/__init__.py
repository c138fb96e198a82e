"""Joint angles as gait laboratories report them: hip, knee, ankle, pelvis, trunk and arms."""
