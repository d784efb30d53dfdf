/* @TITLE@: what it is says @NAME@.h. */
#include "@NAME@.h"

#include <math.h>

const @NAME@_parameters @NAME@_defaults = {
@DEFAULTS@
};
@TABLES@
void @NAME@_derivatives(double t, const double x[], const double u[], const @NAME@_parameters *p,@HELD_ARGUMENT@ double dx[])
{
@UNPACKED@@HELD_UNPACKED@@DERIVATIVES@@RATES@
}

void @NAME@_outputs(double t, const double x[], const double u[], const @NAME@_parameters *p, double y[])
{
@UNPACKED@@SHOWN@@READINGS@
}
@HELD@
static void advanced(const double x[], double h, const double rate[], double next[])
{
    for (int k = 0; k < @NAME@_STATES; ++k) {
        next[k] = x[k] + h * rate[k];
    }
}

void @NAME@_step(double t, double x[], const double u[], double h, const @NAME@_parameters *p)
{
    double k1[@NAME@_STATES], k2[@NAME@_STATES], k3[@NAME@_STATES], k4[@NAME@_STATES], next[@NAME@_STATES];
@BEGIN@    @NAME@_derivatives(t, x, u, p,@HELD_PASSED@ k1);
    advanced(x, 0.5 * h, k1, next);
    @NAME@_derivatives(t + 0.5 * h, next, u, p,@HELD_PASSED@ k2);
    advanced(x, 0.5 * h, k2, next);
    @NAME@_derivatives(t + 0.5 * h, next, u, p,@HELD_PASSED@ k3);
    advanced(x, h, k3, next);
    @NAME@_derivatives(t + h, next, u, p,@HELD_PASSED@ k4);
    for (int k = 0; k < @NAME@_STATES; ++k) {
        x[k] += h / 6.0 * (k1[k] + 2.0 * k2[k] + 2.0 * k3[k] + k4[k]);
    }
}

#ifdef @NAME@_MAIN
#include <stdio.h>

static int read_row(double row[])
{
    for (int k = 0; k <= @NAME@_INPUTS; ++k) {
        if (scanf(k == 0 ? "%lf" : ",%lf", &row[k]) != 1) {
            return 0;
        }
    }
    return 1;
}

int main(void)
{
    double x[@NAME@_STATES] = { 0.0 }, y[@NAME@_OUTPUTS], row[@NAME@_INPUTS + 1], next[@NAME@_INPUTS + 1];
    const @NAME@_parameters *p = &@NAME@_defaults;
    int more;
    /* The first line has the names: t, @INPUTS@. */
    if (scanf("%*[^\n]") == EOF || !read_row(row)) {
        fputs("give a table with the columns t,@INPUTS@\n", stderr);
        return 2;
    }
    puts("t,@OUTPUTS@");
    do {
        @NAME@_outputs(row[0], x, row + 1, p, y);
        printf("%.17g", row[0]);
        for (int k = 0; k < @NAME@_OUTPUTS; ++k) {
            printf(",%.17g", y[k]);
        }
        putchar('\n');
        more = read_row(next);
        if (more) {
            double steps = ceil((next[0] - row[0]) / @NAME@_STEP_S - 1e-9);
            double h = (next[0] - row[0]) / (steps > 1.0 ? steps : 1.0);
            for (double k = 0.0; k < (steps > 1.0 ? steps : 1.0); k += 1.0) {
                @NAME@_step(row[0] + k * h, x, row + 1, h, p);
            }
        }
        for (int k = 0; k <= @NAME@_INPUTS; ++k) {
            row[k] = next[k];
        }
    } while (more);
    return 0;
}
#endif
