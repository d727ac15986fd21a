!> Memory of the process.
module lopin_memory
   use lopin_kinds, only : wp
   implicit none
   private
   public :: peak_memory

contains

   !> Peak resident memory of the process as the system counts it [MiB]; 0 where it does not say.
   real(wp) function peak_memory() result(mib)
      integer :: unit, status
      character(len=120) :: line

      mib = 0.0_wp
      open (newunit=unit, file='/proc/self/status', action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (line(:6) /= 'VmHWM:') cycle
         read (line(7:), *, iostat=status) mib
         mib = mib/1024.0_wp
         exit
      end do
      close (unit)
   end function peak_memory
end module lopin_memory
