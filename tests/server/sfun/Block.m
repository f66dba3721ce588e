% The part of Simulink.MSFcnRunTimeBlock that a level-2 S-function uses; anything else is an error.
classdef Block < handle
  properties
    NumDialogPrms = 0;
    NumInputPorts = 0;
    NumOutputPorts = 0;
    SampleTimes = [];
    SimStateCompliance = '';
    BlockHandle = 0;
    DialogPrm = struct ('Data', {});
    InputPort = struct ('Dimensions', {}, 'DatatypeID', {}, 'Complexity', {}, 'SamplingMode', {}, 'DirectFeedthrough', {}, 'Data', {});
    OutputPort = struct ('Dimensions', {}, 'DatatypeID', {}, 'Complexity', {}, 'SamplingMode', {}, 'Data', {});
    Methods = struct ();
  end
  methods
    function self = Block (number, parameters)
      self.BlockHandle = number;
      for k = 1:numel (parameters)
        self.DialogPrm(k).Data = parameters{k};
      end
    end
    function SetPreCompInpPortInfoToDynamic (self)
      for k = 1:self.NumInputPorts
        self.InputPort(k).Data = [];
      end
    end
    function SetPreCompOutPortInfoToDynamic (self)
      for k = 1:self.NumOutputPorts
        self.OutputPort(k).Data = [];
      end
    end
    function RegBlockMethod (self, name, method)
      self.Methods.(name) = method;
    end
    function call (self, name)
      method = self.Methods.(name);
      method (self);
    end
  end
end
