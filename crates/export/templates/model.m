function model = @NAME@()
% @TITLE@
%
% A dynamic model written by drivemon @VERSION@ from @SOURCE@.
@REMARKS@%
% Space vectors are amplitude-invariant, in the frame of the stator; all units are SI. Voltages, currents and speed are what the
% instruments show, where the motor file has effects on instruments. For MATLAB and Octave:
%
%     m = @NAME@();
%     p = m.parameters; x = m.start;
%     for k = 0:4999
%         t = k * m.step_s;
%         u = [...];                        % as in m.inputs: volts of the phases, load torque, supply frequency
%         y = m.output(t, x, u, p);         % as in m.outputs
%         x = m.step(t, x, u, m.step_s, p); % a classical Runge-Kutta step, u held
%     end
%
% m.derivatives(t, x, u, p@HELD_ARGUMENT@) gives the rates of change as a row, for an integrator of your own.
    model.parameters = parameters();
    model.states = {@STATES@};
    model.start = zeros(1, @STATE_COUNT@);
    model.inputs = {@INPUTS@};
    model.outputs = {@OUTPUTS@};
    model.step_s = @STEP@;                   % step of the simulation from which the model comes, s
    model.derivatives = @derivatives;
    model.output = @output;
    model.step = @step;
@HELD_HANDLE@end

function p = parameters()
@PARAMETERS@
end

% Rates of change of the states, per second.
function rates = derivatives(t, x, u, p@HELD_ARGUMENT@)
@UNPACKED@@HELD_UNPACKED@@DERIVATIVES@    rates = [ ...
@RATES@];
end

% What the instruments show, and the torque.
function y = output(t, x, u, p)
@UNPACKED@@SHOWN@    y = [ ...
@READINGS@];
end
@HELD@
% The states after a Runge-Kutta step of h seconds, inputs held.
function x = step(t, x, u, h, p)
@BEGIN@    k1 = derivatives(t, x, u, p@HELD_ARGUMENT@);
    k2 = derivatives(t + 0.5 * h, x + 0.5 * h * k1, u, p@HELD_ARGUMENT@);
    k3 = derivatives(t + 0.5 * h, x + 0.5 * h * k2, u, p@HELD_ARGUMENT@);
    k4 = derivatives(t + h, x + h * k3, u, p@HELD_ARGUMENT@);
    x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
end
@CHOICE@@TABLES@
