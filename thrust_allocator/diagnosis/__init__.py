"""What a pilot should know: findings as they come and go, what is missing and why, figures."""
