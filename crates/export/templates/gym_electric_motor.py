"""@TITLE@

Parameters for gym-electric-motor (names of its version 3.0), written by drivemon @VERSION@ from @SOURCE@.
Its squirrel-cage motor is linear. What becomes of the effects of the motor file:
@LOST@
    import gym_electric_motor as gem
    from gym_electric_motor.physical_systems.mechanical_loads import PolynomialStaticLoad
    import @NAME@

    environment = gem.make(
        "Cont-CC-SCIM-v0",
        motor=dict(motor_parameter=@NAME@.MOTOR, nominal_values=@NAME@.NOMINAL, limit_values=@NAME@.LIMITS),
        load=PolynomialStaticLoad(load_parameter=@NAME@.LOAD),
    )
"""

MOTOR = dict(
    p=@POLE_PAIRS@,
    r_s=@R_S@,  # ohm
    r_r=@R_R@,  # ohm
    l_m=@L_M@,  # H
    l_sigs=@L_LS@,  # H
    l_sigr=@L_LR@,  # H
    j_rotor=@J_ROTOR@,  # kg m2
)

# Torque against the motion: a + b omega + c omega^2. Of the inertia a millionth is the load's: it must have some.
LOAD = dict(
    a=@COULOMB@,  # N m
    b=@FRICTION@,  # N m s
    c=@WINDAGE@,  # N m s2
    j_load=@J_LOAD@,  # kg m2
)

# Of the plate; u is the voltage of the DC link that gives the rated voltage at the border of linear modulation, twice its crest.
NOMINAL = dict(i=@NOMINAL_I@, u=@NOMINAL_U@, omega=@NOMINAL_OMEGA@, torque=@NOMINAL_TAU@)
# What a controller may reach is not in a motor file: half as much again of current and speed.
LIMITS = dict(i=@LIMIT_I@, u=@NOMINAL_U@, omega=@LIMIT_OMEGA@)
