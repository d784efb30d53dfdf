/* @TITLE@
 *
 * A dynamic model written by drivemon @VERSION@ from @SOURCE@.
@REMARKS@ *
 * Space vectors are amplitude-invariant, in the frame of the stator; all units are SI. Voltages, currents and speed are what the
 * instruments show, where the motor file has effects on instruments.
 *
 *     @NAME@_parameters p = @NAME@_defaults;
 *     double x[@NAME@_STATES] = { 0.0 }, u[@NAME@_INPUTS], y[@NAME@_OUTPUTS];
 *     for (int k = 0; k < 5000; ++k) {
 *         double t = k * @NAME@_STEP_S;
 *         ... set u ...
 *         @NAME@_outputs(t, x, u, &p, y);
 *         @NAME@_step(t, x, u, @NAME@_STEP_S, &p);
 *     }
 *
 * Compiled with -D@NAME@_MAIN it is a program that reads a table of inputs with their time and prints the outputs:
 *     cc -O2 -D@NAME@_MAIN @NAME@.c -lm -o @NAME@ && ./@NAME@ < inputs.csv > outputs.csv
 */
#ifndef @NAME@_H
#define @NAME@_H

#ifdef __cplusplus
extern "C" {
#endif

/* Step of the simulation from which the model comes, s. */
#define @NAME@_STEP_S @STEP@

/* Constants of the motor and its effects. */
typedef struct {
@PARAMETERS@
} @NAME@_parameters;

extern const @NAME@_parameters @NAME@_defaults;

/* States, all zero at the beginning:
@STATE_NOTES@ */
enum { @NAME@_STATES = @STATE_COUNT@ };

/* Inputs:
@INPUT_NOTES@ */
enum { @NAME@_INPUTS = @INPUT_COUNT@ };

/* Outputs:
@OUTPUT_NOTES@ */
enum { @NAME@_OUTPUTS = @OUTPUT_COUNT@ };

/* Rates of change dx of the states x, per second, at time t (s) and inputs u@HELD_NOTE@. */
void @NAME@_derivatives(double t, const double x[], const double u[], const @NAME@_parameters *p,@HELD_ARGUMENT@ double dx[]);

/* What the instruments show, and the torque. */
void @NAME@_outputs(double t, const double x[], const double u[], const @NAME@_parameters *p, double y[]);
@HELD_HEADER@
/* A classical Runge-Kutta step of h seconds from time t; the inputs are held. */
void @NAME@_step(double t, double x[], const double u[], double h, const @NAME@_parameters *p);

#ifdef __cplusplus
}
#endif

#endif
