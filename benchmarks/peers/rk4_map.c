/* The same map by fixed-step Runge-Kutta: CASE 1, every cell with one tangent vector, cells in SIMD lanes, OpenMP over blocks.
 *
 * The corner of the law is stepped over as it comes, which is what makes a fixed-step program simple and fast. The
 * drive is the same for all cells at a stage, so its cosines are tabled once a period.
 *
 *   gcc -O3 -march=native -ffast-math -fopenmp -shared -fPIC rk4_map.c -o rk4_map.so -lm
 */
#include <math.h>
#include <stdlib.h>

#define LANES 32 /* four AVX-512 vectors in flight hide the latency of their chains */

static inline double law(double p) { return p - fmin(1.0, fmax(-1.0, p)); }

void rk4_map(long cells, const double *inverse_alpha, const double *zeta, const double *p0, const double *v0, double omega, long periods,
             long skip, long steps, double *lyapunov, double *last) {
    const double period = 2.0 * M_PI / omega, h = period / steps;
    double *cosine = malloc(sizeof(double) * (2 * steps + 1));
    for (long k = 0; k <= 2 * steps; k++) cosine[k] = cos(M_PI * k / steps);
#pragma omp parallel for schedule(dynamic)
    for (long block = 0; block < cells; block += LANES) {
        double p[LANES], v[LANES], a[LANES], b[LANES], d[LANES], alpha[LANES], sum[LANES];
        const long here = cells - block < LANES ? cells - block : LANES;
        for (long i = 0; i < LANES; i++) {
            const long cell = block + (i < here ? i : here - 1);
            p[i] = p0[cell];
            v[i] = v0[cell];
            b[i] = sum[i] = 0.0;
            a[i] = 1.0;
            d[i] = 2.0 * zeta[cell];
            alpha[i] = 1.0 / inverse_alpha[cell];
        }
        for (long k = 0; k < periods; k++) {
            for (long s = 0; s < steps; s++) {
                const double c0 = cosine[2 * s], c1 = cosine[2 * s + 1], c2 = cosine[2 * s + 2];
#pragma omp simd
                for (long i = 0; i < LANES; i++) {
                    const double f0 = alpha[i] * c0, f1 = alpha[i] * c1, f2 = alpha[i] * c2, g = d[i];
                    const double P = p[i], V = v[i], A = a[i], B = b[i];
                    double q = P, w = V, x = A, y = B;
                    const double k1 = f0 - g * w - law(q), l1 = -g * y - (fabs(q) > 1.0 ? x : 0.0), m1 = w, n1 = y;
                    q = P + 0.5 * h * m1; w = V + 0.5 * h * k1; x = A + 0.5 * h * n1; y = B + 0.5 * h * l1;
                    const double k2 = f1 - g * w - law(q), l2 = -g * y - (fabs(q) > 1.0 ? x : 0.0), m2 = w, n2 = y;
                    q = P + 0.5 * h * m2; w = V + 0.5 * h * k2; x = A + 0.5 * h * n2; y = B + 0.5 * h * l2;
                    const double k3 = f1 - g * w - law(q), l3 = -g * y - (fabs(q) > 1.0 ? x : 0.0), m3 = w, n3 = y;
                    q = P + h * m3; w = V + h * k3; x = A + h * n3; y = B + h * l3;
                    const double k4 = f2 - g * w - law(q), l4 = -g * y - (fabs(q) > 1.0 ? x : 0.0);
                    p[i] = P + h / 6.0 * (m1 + 2.0 * (m2 + m3) + w);
                    v[i] = V + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
                    a[i] = A + h / 6.0 * (n1 + 2.0 * (n2 + n3) + y);
                    b[i] = B + h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
                }
            }
            for (long i = 0; i < LANES; i++) {
                const double size = sqrt(a[i] * a[i] + b[i] * b[i]);
                if (k >= skip) sum[i] += log(size);
                a[i] /= size;
                b[i] /= size;
            }
        }
        for (long i = 0; i < here; i++) {
            lyapunov[block + i] = sum[i] / ((periods - skip) * period);
            last[block + i] = p[i];
        }
    }
    free(cosine);
}
