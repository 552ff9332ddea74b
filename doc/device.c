/* SPDX-License-Identifier: MIT-0 */
/* device.c: 1000 oscillators under one record, on the first device of OpenCL and by NAME_batch;
 * link with -lOpenCL and -lm */
#define CL_TARGET_OPENCL_VERSION 120
#include "oscillator_pl.h"
#include <CL/cl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 1000, ROWS = 500, STATES = OSCILLATOR_BATCH_ROWS * COUNT, OUTPUTS = OSCILLATOR_OUTPUTS * COUNT };
static double y[STATES], start[STATES], factors[OSCILLATOR_BATCH_FACTORS * COUNT], peak[OUTPUTS], first[OUTPUTS];
static double sum[4 * OUTPUTS], record[ROWS * OSCILLATOR_INPUTS], now[(ROWS + 1) * OSCILLATOR_BATCH_SHARED];
static oscillator_instances b, device;
static cl_context context;

static cl_mem memory(double *from, size_t size)
{
	return clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, size, from, NULL);
}

int main(void)
{
	static char source[1 << 20];
	const char *text = source;
	FILE *f = fopen("oscillator_pl.cl", "r");
	cl_platform_id platform;
	cl_device_id id;
	if (!f || fread(source, 1, sizeof source - 1, f) == 0 || clGetPlatformIDs(1, &platform, NULL) != CL_SUCCESS ||
	    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, NULL) != CL_SUCCESS)
		return 2;
	context = clCreateContext(NULL, 1, &id, NULL, NULL, NULL);
	cl_command_queue queue = clCreateCommandQueue(context, id, 0, NULL);
	cl_program program = clCreateProgramWithSource(context, 1, &text, NULL, NULL);
	if (clBuildProgram(program, 1, &id, "", NULL, NULL) != CL_SUCCESS)
		return 3;
	cl_kernel kernel = clCreateKernel(program, "oscillator_kernel", NULL);

	b.count = COUNT, b.y = y, b.factors = factors, b.peak = peak;
	oscillator_batch_init(&b);
	for (size_t j = 0; j < COUNT; j++) {
		static oscillator_coeffs c;
		const double params[OSCILLATOR_PARAMS] = { 5.0 + 0.01 * (double)j, 0.05 };
		if (oscillator_retune(&c, params, OSCILLATOR_H) == 0)
			oscillator_batch_use(&b, j, &c);
	}
	for (int k = 0; k < ROWS; k++)
		record[k] = sin(0.1 * k);
	memcpy(start, y, sizeof y);
	memcpy(first, peak, sizeof peak);
	device = b;
	oscillator_batch_share(&device, ROWS, record, now);

	const cl_ulong number[] = { COUNT, 0, ROWS };           /* instances; steps taken, to be taken */
	const size_t items = COUNT;
	cl_mem argument[] = { memory(start, sizeof start), memory(factors, sizeof factors), memory(now, sizeof now),
			      memory(first, sizeof first), memory(sum, sizeof sum) };
	for (cl_uint i = 0; i < 3; i++)
		clSetKernelArg(kernel, i, sizeof number[i], &number[i]);
	for (cl_uint i = 0; i < 5; i++)
		clSetKernelArg(kernel, 3 + i, sizeof argument[i], &argument[i]);
	clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &items, NULL, 0, NULL, NULL);
	clEnqueueReadBuffer(queue, argument[0], CL_TRUE, 0, sizeof start, start, 0, NULL, NULL);
	clEnqueueReadBuffer(queue, argument[3], CL_TRUE, 0, sizeof first, first, 0, NULL, NULL);
	clEnqueueReadBuffer(queue, argument[4], CL_TRUE, 0, sizeof sum, sum, 0, NULL, NULL);

	oscillator_batch(&b, ROWS, record, NULL);
	printf("states %s, peaks %s; of instance 500: peak %.17g, mean %.17g\n",
	       memcmp(start, y, sizeof y) ? "differ" : "are equal",
	       memcmp(first, peak, sizeof peak) ? "differ" : "are equal",
	       first[500], sum[500] / ROWS);
	return memcmp(start, y, sizeof y) || memcmp(first, peak, sizeof peak);
}
