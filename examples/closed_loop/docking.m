% Steers a camera to a docking ring by what a server measures, as docking.py: `panwright serve client.pxn`, then
%   octave-cli docking.m [PORT]
1;
addpath (fullfile (fileparts (mfilename ("fullpath")), "..", "..", "server", "clients"));

fov = deg2rad (40);
finish = 3;  % metres above the surface
position = [2.0, -1.5, 14.0];
words = argv ();
port = 10363;
if numel (words) > 0 && ! isnan (str2double (words{end}))
  port = str2double (words{end});
endif
server = panwright_client ("127.0.0.1", port);
server.set_field_of_view (fov);
server.set_sun (0, pi / 2);
docked = false;
for step = 0:39
  server.set_viewpoint (position, [0 1 0 0]);
  grey = double (server.image ()(:, :, 2));
  [height, width] = size (grey);
  total = max (sum (grey(:)), 1);
  x = sum (sum (grey, 1) .* ((1:width) - 0.5)) / total / width;
  y = 1 - sum (sum (grey, 2)' .* ((1:height) - 0.5)) / total / height;
  point = server.point (x, y);
  if isempty (point)
    error ("the client is out of sight");
  endif
  range = position(3) - point(3);
  aside = ([x, y] - 0.5) * 2 * tan (fov / 2) * range;
  printf ("step %d: %.3f m above the surface, %.3f m off its middle\n", step, range, norm (aside));
  if abs (range - finish) < 0.05 && norm (aside) < 0.02
    printf ("docked at %.2f %.2f %.2f\n", position);
    docked = true;
    break
  endif
  position += [aside / 2, -(range - finish) / 3];
endfor
server.close ();
if ! docked
  error ("the camera did not reach the ring");
endif
