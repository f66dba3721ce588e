% Client of `panwright serve` for Octave with the package sockets and for MATLAB from R2020b: a session as a struct of functions.
%
%   server = panwright_client ('127.0.0.1', 10363);
%   server.set_viewpoint ([0 0 14], [0 1 0 0]);
%   image = server.image ();                       % H x W x 3, 0 to 255
%   server.close ();
%
% Metres, radians; world_from_camera quaternions w x y z, camera x right, y down, z forward. docs/server-protocol.md
function server = panwright_client (address, port)
  wire = connected (address, port);
  wire.send (word (hex2dec ('114')));
  expect (wire, 0);
  server.set_viewpoint = @(position, quaternion) command (wire, 269, doubles ([position, quaternion]));
  server.set_field_of_view = @(radians) command (wire, 279, floats (radians));
  server.set_sun = @(azimuth, elevation) command (wire, 280, doubles ([149597870700, azimuth, elevation]));
  server.set_object = @(number, position, quaternion) command (wire, 270, [word(number), doubles([position, quaternion])]);
  server.image = @() get_image (wire);
  server.point = @(x, y) get_point (wire, x, y);
  server.pulse = @(position, direction) get_pulse (wire, position, direction);
  server.close = @() leave (wire);
end

% A connection as functions: send (bytes), take (count) of some bytes, at least one, and close ().
function wire = connected (address, port)
  if exist ('OCTAVE_VERSION', 'builtin')
    pkg load sockets
    at = socket (AF_INET, SOCK_STREAM, 0);
    if connect (at, struct ('addr', address, 'port', port)) ~= 0
      error ('panwright_client: no server at %s:%d', address, port);
    end
    wire = struct ('send', @(bytes) send (at, bytes), 'take', @(count) recv (at, min (count, 65536)), 'close', @() disconnect (at));
  else
    at = tcpclient (address, port);
    wire = struct ('send', @(bytes) write (at, bytes, 'uint8'), 'take', @(count) uint8 (read (at, count, 'uint8')), 'close', @() delete (at));
  end
end

function bytes = word (value)
  bytes = fliplr (typecast (uint32 (value), 'uint8'));
end

% The IEEE words, turned left by 9 bits.
function bytes = floats (values)
  bytes = uint8 ([]);
  for value = values
    bits = uint64 (typecast (single (value), 'uint32'));
    bits = bitshift (bits, 9);
    bytes = [bytes, word(bitand (bits, uint64 (4294967295)) + bitshift (bits, -32))];
  end
end

% Both IEEE words, turned left by 12 bits together, the low one first.
function bytes = doubles (values)
  bytes = uint8 ([]);
  for value = values
    halves = uint64 (typecast (double (value), 'uint32'));
    least = bitand (bitshift (halves(1), 12), uint64 (4294967295)) + bitshift (halves(2), -20);
    most = bitand (bitshift (halves(2), 12), uint64 (4294967295)) + bitshift (halves(1), -20);
    bytes = [bytes, word(least), word(most)];
  end
end

function bytes = get_bytes (wire, count)
  bytes = zeros (1, count, 'uint8');
  at = 0;
  while at < count
    part = wire.take (count - at);
    if isempty (part)
      error ('panwright_client: the server closed the connection');
    end
    bytes(at + (1:numel (part))) = part;
    at = at + numel (part);
  end
end

function value = get_word (wire)
  value = double (typecast (fliplr (get_bytes (wire, 4)), 'uint32'));
end

function value = get_float (wire)
  bits = uint64 (get_word (wire));
  bits = bitshift (bits, -9) + bitshift (bitand (bits, uint64 (511)), 23);
  value = double (typecast (uint32 (bits), 'single'));
end

function expect (wire, code)
  got = get_word (wire);
  if got == 1
    number = get_word (wire);
    lengths = double (get_bytes (wire, 2));
    error ('panwright_client: %s (%d)', char (get_bytes (wire, lengths(1) * 256 + lengths(2))), number);
  elseif got ~= code
    error ('panwright_client: reply %d, expected %d', got, code);
  end
end

function ask (wire, number, fields, code)
  wire.send ([word(number), fields]);
  expect (wire, code);
end

function command (wire, number, fields)
  ask (wire, number, fields, 0);
end

% A binary PPM or PGM of 8 bits.
function image = get_image (wire)
  ask (wire, 1, uint8 ([]), 2);
  bytes = get_bytes (wire, get_word (wire));
  header = sscanf (char (bytes(3:min (end, 40))), '%d', 3);
  channels = 1 + 2 * (bytes(2) == uint8 ('6'));
  pixels = bytes(end - header(1) * header(2) * channels + 1:end);
  image = permute (reshape (pixels, [channels, header(1), header(2)]), [3, 2, 1]);
end

% The world point under an image place, from (0, 0) lower left to (1, 1) upper right; empty: nothing is there.
function point = get_point (wire, x, y)
  ask (wire, 4, floats ([x, y]), 5);
  point = [get_float(wire), get_float(wire), get_float(wire)];
  if get_bytes (wire, 1) == 0
    point = [];
  end
end

function [range, cosine] = get_pulse (wire, position, direction)
  ask (wire, 13, floats ([position, direction]), 9);
  range = get_float (wire);
  cosine = get_float (wire);
end

function leave (wire)
  wire.send (word (0));
  wire.close ();
end
