# Writes FOLDER/smoke.nrrd (floats, 128 x 128 x 128, x fastest) and FOLDER/smoke.vdb: a plume of smoke in the cube from -1
# to 1, of random numbers that are smoothed over several lengths. Without pyopenvdb (python3-openvdb) the second is left out.
# Arguments: FOLDER.
import os
import sys

import numpy

N = 128
folder = sys.argv[1]
random = numpy.random.RandomState(7)
frequency = numpy.fft.fftfreq(N) * N
length = numpy.sqrt(frequency[:, None, None] ** 2 + frequency[None, :, None] ** 2 + frequency[None, None, :] ** 2)
spectrum = numpy.fft.fftn(random.standard_normal((N, N, N))) / numpy.maximum(length, 2) ** 2.2
noise = numpy.fft.ifftn(spectrum).real
noise /= noise.std()
middle = (numpy.arange(N) + .5) / N * 2 - 1
x, y, z = numpy.meshgrid(middle, middle, middle, indexing='ij')
radius = .25 + .3 * (y + 1) / 2
plume = 1 - numpy.sqrt(x * x + z * z) / radius - numpy.maximum(numpy.abs(y) - .7, 0) * 4
density = numpy.clip(plume + .35 * noise, 0, 1)
density[[0, -1]] = density[:, [0, -1]] = density[:, :, [0, -1]] = 0
density = density.astype(numpy.float32)
with open(os.path.join(folder, 'smoke.nrrd'), 'wb') as file:
    file.write(b'NRRD0004\ntype: float\ndimension: 3\nsizes: 128 128 128\nendian: little\nencoding: raw\n\n')
    file.write(density.transpose(2, 1, 0).astype('<f4').tobytes())
try:
    import pyopenvdb as vdb
except ImportError:
    sys.exit(0)
grid = vdb.FloatGrid()
# Gray's axis y points up, Blender's z: (x, y, z) becomes (x, -z, y).
grid.copyFromArray(numpy.ascontiguousarray(density.transpose(0, 2, 1)[:, ::-1, :]))
grid.transform = vdb.createLinearTransform(voxelSize=2 / N)
grid.transform.translate((-1 + 1 / N, -1 + 1 / N, -1 + 1 / N))
grid.name = 'density'
vdb.write(os.path.join(folder, 'smoke.vdb'), grids=[grid])
