"""What instruments should read: residual, Jacobian and noise of markers, posture and plates against the body."""
