/* Solutions with the lower triangle of a supernode, in single precision.
 *
 * Such blocks are small: calls of a library for one column after the other take longer than the
 * products. Four columns are taken at a time; the procedures are compiled once more for processors
 * with vectors of eight numbers (nothing is fused: the same bits). Triangles are stored by columns,
 * `rows` numbers apart; `inverse` are those of the pivots. */
#include <stddef.h>
#include <string.h>
#include "every_processor.h"

enum { PARTS = 8, AT_A_TIME = 4 };
typedef float parts_type __attribute__((vector_size(PARTS * sizeof(float))));

/* y <- L^-1 y: what is found is taken from all that follows. */
FOR_EACH_PROCESSOR
void lopin_solve_forward(const float *restrict l, int n, int rows, const float *restrict inverse,
                         float *restrict y)
{
    int i, j;
    for (j = 0; j + AT_A_TIME <= n; j += AT_A_TIME) {
        const float *a = l + (size_t)j * (size_t)rows, *b = a + rows, *c = b + rows, *d = c + rows;
        float p = y[j] * inverse[j], q = (y[j + 1] - a[j + 1] * p) * inverse[j + 1], r, s;
        r = (y[j + 2] - a[j + 2] * p - b[j + 2] * q) * inverse[j + 2];
        s = (y[j + 3] - a[j + 3] * p - b[j + 3] * q - c[j + 3] * r) * inverse[j + 3];
        y[j] = p;
        y[j + 1] = q;
        y[j + 2] = r;
        y[j + 3] = s;
        for (i = j + AT_A_TIME; i < n; i++) y[i] -= (a[i] * p + b[i] * q) + (c[i] * r + d[i] * s);
    }
    for (; j < n; j++) {
        const float *a = l + (size_t)j * (size_t)rows;
        y[j] *= inverse[j];
        for (i = j + 1; i < n; i++) y[i] -= a[i] * y[j];
    }
}

/* y <- L^-T y: of each row the sum over all that is found. */
FOR_EACH_PROCESSOR
void lopin_solve_backward(const float *restrict l, int n, int rows, const float *restrict inverse,
                          float *restrict y)
{
    int i, j, k, m, tail = n % AT_A_TIME;
    for (j = n - 1; j >= n - tail; j--) {
        const float *a = l + (size_t)j * (size_t)rows;
        for (i = j + 1; i < n; i++) y[j] -= a[i] * y[i];
        y[j] *= inverse[j];
    }
    for (j = n - tail - AT_A_TIME; j >= 0; j -= AT_A_TIME) {
        const float *column[AT_A_TIME];
        parts_type sum[AT_A_TIME] = {{0.0f}}, own, of_y;
        float s[AT_A_TIME];
        for (k = 0; k < AT_A_TIME; k++) column[k] = l + (size_t)(j + k) * (size_t)rows;
        for (i = j + AT_A_TIME; i + PARTS <= n; i += PARTS) {
            memcpy(&of_y, y + i, sizeof of_y);
            for (k = 0; k < AT_A_TIME; k++) {
                memcpy(&own, column[k] + i, sizeof own);
                sum[k] += own * of_y;
            }
        }
        for (k = 0; k < AT_A_TIME; k++) {
            s[k] = ((sum[k][0] + sum[k][4]) + (sum[k][2] + sum[k][6]))
                + ((sum[k][1] + sum[k][5]) + (sum[k][3] + sum[k][7]));
            for (m = i; m < n; m++) s[k] += column[k][m] * y[m];
        }
        for (k = AT_A_TIME - 1; k >= 0; k--) {
            for (m = k + 1; m < AT_A_TIME; m++) s[k] += column[k][j + m] * y[j + m];
            y[j + k] = (y[j + k] - s[k]) * inverse[j + k];
        }
    }
}
