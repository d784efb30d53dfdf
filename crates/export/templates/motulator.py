"""@TITLE@

Parameters for motulator (names of its version 0.5), written by drivemon @VERSION@ from @SOURCE@.
motulator's induction machine is linear. What becomes of the effects of the motor file:
@LOST@
    from motulator.drive import model, utils
    import @NAME@

    machine = model.InductionMachine(utils.InductionMachinePars(**@NAME@.MACHINE))
    mechanics = model.StiffMechanicalSystem(**@NAME@.MECHANICS)
"""

# Gamma model: the same motor at its terminals as the T model of the motor file.
MACHINE = dict(
    n_p=@POLE_PAIRS@,
    R_s=@R_S@,  # ohm
    R_r=@GAMMA_R_R@,  # ohm
    L_ell=@GAMMA_L_ELL@,  # H
    L_s=@GAMMA_L_S@,  # H
)

# Inverse-Gamma model, for utils.InductionMachineInvGammaPars and the controllers.
MACHINE_INVERSE_GAMMA = dict(
    n_p=@POLE_PAIRS@,
    R_s=@R_S@,  # ohm
    R_R=@INV_R_R@,  # ohm
    L_sgm=@INV_L_SGM@,  # H
    L_M=@INV_L_M@,  # H
)


def friction(omega):
    """Friction coefficient at a speed in rad/s, N m s: viscous friction and windage."""
    return @FRICTION@ + @WINDAGE@ * abs(omega)


MECHANICS = dict(
    J=@INERTIA@,  # kg m2
    B_L=friction,
)
