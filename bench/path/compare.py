# Pictures as bench/path.sh needs them: compare.py REFERENCE PICTURE prints relMSE, the mean of (x - r)^2 / (r^2 + .01)
# over pixels and channels, and the mean of the reference. Reads PFM and uncompressed EXR of single precision.
import struct
import sys


def pfm(data):
    _, size, _, rest = data.split(b'\n', 3)
    width, height = map(int, size.split())
    rows = [struct.unpack_from('<%df' % (3 * width), rest, 12 * width * y) for y in range(height)]
    return [value for row in reversed(rows) for value in row]


def exr(data):
    at, header = 8, {}
    while data[at] != 0:
        name, kind, rest = data[at:at + 512].split(b'\0', 2)
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from('<i', data, at)
        header[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    x0, y0, x1, y1 = struct.unpack('<4i', header['dataWindow'])
    width, height, names, channels = x1 - x0 + 1, y1 - y0 + 1, [], header['channels']
    while channels[0] != 0:
        name, channels = channels.split(b'\0', 1)
        names.append(name.decode())
        if struct.unpack_from('<i', channels)[0] != 2:
            sys.exit('not single precision')
        channels = channels[16:]
    if header['compression'] != b'\0':
        sys.exit('compressed')
    out = []
    for start in struct.unpack_from('<%dQ' % height, data, at + 1):
        rows = {name: struct.unpack_from('<%df' % width, data, start + 8 + 4 * width * i)
                for i, name in enumerate(names)}
        out += [value for pixel in zip(rows['R'], rows['G'], rows['B']) for value in pixel]
    return out


def picture(name):
    with open(name, 'rb') as file:
        data = file.read()
    return pfm(data) if data[:2] == b'PF' else exr(data)


reference, x = picture(sys.argv[1]), picture(sys.argv[2])
print('%.6f %.4f' % (sum((a - r) ** 2 / (r * r + .01) for a, r in zip(x, reference)) / len(reference),
                     sum(reference) / len(reference)))
