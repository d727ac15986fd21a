!> A pressure-overclosure law (EXPONENTIAL, TABULAR): a spring whose force is weight *
!> pressure(overclosure).
module lopin_enforcement_law
   use lopin_kinds, only : wp
   use lopin_enforcement, only : enforcement_type
   implicit none
   private
   public :: law_type, new_exponential, new_tabular

   !> An exponential law goes on along its tangent from here, in overclosures over c0, plus 1.
   real(wp), parameter :: linear_from = 6.0_wp
   !> Gaps below this share of the first line of a table are rounding.
   real(wp), parameter :: touching = 1.0e-12_wp

   type, extends(enforcement_type) :: law_type
      logical :: exponential = .true.
      real(wp) :: p0 = 0.0_wp, c0 = 1.0_wp   !! pressure at zero gap, gap where it starts
      real(wp), allocatable :: pressure(:), overclosure(:)     !! table, both increasing
   contains
      procedure :: word
      procedure :: solves_for_multiplier
      procedure :: piecewise_linear
      procedure :: first_gap
      procedure :: trial
      procedure :: forces
      procedure :: stored
   end type law_type

contains

   !> Exponential pressure-overclosure.
   subroutine new_exponential(self, p0, c0)
      type(law_type), intent(out) :: self
      real(wp), intent(in) :: p0   !! pressure at zero clearance [stress]
      real(wp), intent(in) :: c0   !! clearance at zero pressure [length]

      self%exponential = .true.
      self%p0 = p0
      self%c0 = c0
      allocate (self%pressure(0), self%overclosure(0))
   end subroutine new_exponential

   !> Pressure-overclosure by points [stress], [length].
   subroutine new_tabular(self, pressure, overclosure)
      type(law_type), intent(out) :: self
      real(wp), intent(in) :: pressure(:), overclosure(:)

      self%exponential = .false.
      self%pressure = pressure
      self%overclosure = overclosure
   end subroutine new_tabular

   function word(self)
      class(law_type), intent(in) :: self
      character(len=:), allocatable :: word
      word = 'tabular'
      if (self%exponential) word = 'exponential'
   end function word

   pure logical function solves_for_multiplier(self)
      class(law_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .false.
      end associate
   end function solves_for_multiplier

   pure logical function piecewise_linear(self)
      class(law_type), intent(in) :: self
      associate (unused => self)
         piecewise_linear = .false.
      end associate
   end function piecewise_linear

   pure real(wp) function first_gap(self)
      class(law_type), intent(in) :: self

      if (self%exponential) then
         first_gap = max(self%c0, 0.0_wp)
      else
         first_gap = max(-self%overclosure(1), 0.0_wp)
      end if
   end function first_gap

   !> Here alpha is the weight of the point: pressure times alpha is force.
   elemental subroutine trial(self, gap, alpha, multiplier, force, stiffness)
      class(law_type), intent(in) :: self
      real(wp), intent(in) :: gap, alpha, multiplier
      real(wp), intent(out) :: force, stiffness

      associate (unused => multiplier)
         call pressure_law(self, -gap, force, stiffness)
      end associate
      force = force*alpha
      stiffness = stiffness*alpha
   end subroutine trial

   !> A law never pulls, and what just touches has its slope.
   elemental subroutine forces(self, gap, alpha, multiplier, bilateral, force, stiffness)
      class(law_type), intent(in) :: self
      real(wp), intent(in) :: gap, alpha, multiplier
      logical, intent(in) :: bilateral
      real(wp), intent(out) :: force, stiffness

      associate (unused => bilateral)
         call self%trial(gap, alpha, multiplier, force, stiffness)
      end associate
   end subroutine forces

   !> The integral of the pressure over the overclosure.
   elemental real(wp) function stored(self, gap, force, alpha) result(energy)
      class(law_type), intent(in) :: self
      real(wp), intent(in) :: gap, force, alpha
      real(wp) :: t, far, p, slope, last, from
      integer :: i, n

      associate (unused => force)
      end associate
      energy = 0.0_wp
      call pressure_law(self, -gap, p, slope)
      if (.not. p > 0.0_wp) return
      if (self%exponential) then
         t = 1.0_wp - gap/self%c0
         far = max(t - linear_from, 0.0_wp)*self%c0
         t = min(t, linear_from)
         energy = self%p0*self%c0/(exp(1.0_wp) - 1.0_wp) &
            & *((t - 1.0_wp)*exp(t) + 1.0_wp - 0.5_wp*t**2) + far*(p - 0.5_wp*slope*far)
      else
         n = size(self%pressure)
         last = p
         from = -gap
         do i = n, 1, -1
            if (self%overclosure(i) >= from) cycle
            energy = energy + 0.5_wp*(last + self%pressure(i))*(from - self%overclosure(i))
            last = self%pressure(i)
            from = self%overclosure(i)
         end do
      end if
      energy = alpha*energy
   end function stored

   !> Pressure and its slope. Exponential: p = p0/(e-1) t (e^t - 1), t = overclosure/c0 + 1
   !> (Abaqus); beyond t = 6 it goes on along its tangent, so that no trial overclosure overflows.
   elemental subroutine pressure_law(self, overclosure, pressure, slope)
      type(law_type), intent(in) :: self
      real(wp), intent(in) :: overclosure     !! penetration [length]
      real(wp), intent(out) :: pressure       !! [stress]
      real(wp), intent(out) :: slope          !! [stress/length]
      real(wp) :: t, far
      integer :: i, n

      pressure = 0.0_wp
      slope = 0.0_wp
      if (self%exponential) then
         t = overclosure/self%c0 + 1.0_wp
         if (t <= 0.0_wp) return
         far = max(t - linear_from, 0.0_wp)
         t = min(t, linear_from)
         slope = self%p0/((exp(1.0_wp) - 1.0_wp)*self%c0)*(exp(t) - 1.0_wp + t*exp(t))
         pressure = self%p0/(exp(1.0_wp) - 1.0_wp)*t*(exp(t) - 1.0_wp) + slope*far*self%c0
         return
      end if
      n = size(self%pressure)
      ! What just touches has the slope of the first line: it may hold a body that nothing else
      ! holds.
      if (overclosure < self%overclosure(1) &
         & - touching*(self%overclosure(2) - self%overclosure(1))) return
      do i = 2, n
         if (overclosure > self%overclosure(i) .and. i < n) cycle
         slope = (self%pressure(i) - self%pressure(i - 1))/(self%overclosure(i) &
            & - self%overclosure(i - 1))
         pressure = self%pressure(i - 1) + slope*(overclosure - self%overclosure(i - 1))
         if (i == 2) pressure = max(pressure, 0.0_wp)
         return
      end do
   end subroutine pressure_law
end module lopin_enforcement_law
