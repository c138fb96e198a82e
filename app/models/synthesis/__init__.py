"""Synthesis of motions that nobody recorded (Vasilescu 2002, section 4)."""
