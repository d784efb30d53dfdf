model @NAME@ "@TITLE@"
  // A dynamic model written by drivemon @VERSION@ from @SOURCE@.
@REMARKS@  // Space vectors are amplitude-invariant, in the frame of the stator; all units are SI. Voltages, currents and speed are what the
  // instruments show, where the motor file has effects on instruments.
@PARAMETERS@
@INPUTS@
@OUTPUTS@
@STATES@
protected
@VARIABLES@@TABLES@@FUNCTIONS@equation
@EQUATIONS@@RATES@
@READINGS@
end @NAME@;
