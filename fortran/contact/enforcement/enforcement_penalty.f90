!> Penalty (lecture J.1): a spring of stiffness alpha where the point penetrates, K + alpha G G^T.
module lopin_enforcement_penalty
   use lopin_kinds, only : wp
   use lopin_enforcement, only : enforcement_type, setting_type
   use lopin_enforcement_perturbed, only : perturbed_type
   implicit none
   private
   public :: penalty_type

   type, extends(enforcement_type) :: penalty_type
   contains
      procedure :: word
      procedure :: solves_for_multiplier
      procedure :: trial
      procedure :: stored
      procedure :: form_for_newton
   end type penalty_type

contains

   function word(self)
      class(penalty_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'penalty'
      end associate
   end function word

   pure logical function solves_for_multiplier(self)
      class(penalty_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .false.
      end associate
   end function solves_for_multiplier

   elemental subroutine trial(self, gap, alpha, multiplier, force, stiffness)
      class(penalty_type), intent(in) :: self
      real(wp), intent(in) :: gap, alpha, multiplier
      real(wp), intent(out) :: force, stiffness

      associate (unused => self, also => multiplier)
         force = -alpha*gap
         stiffness = alpha
      end associate
   end subroutine trial

   elemental real(wp) function stored(self, gap, force, alpha)
      class(penalty_type), intent(in) :: self
      real(wp), intent(in) :: gap, force, alpha
      associate (unused => self, also => gap)
         stored = 0.5_wp*force**2/alpha
      end associate
   end function stored

   !> A stiff penalty in its mixed form: the same equations, without its loss of digits, and Newton
   !> does not hop between stick and slip (measured: 5 iterations for 24, 8 for 44). So is one that
   !> sticks exactly, or by a slip that the deck gives.
   subroutine form_for_newton(self, setting, form)
      class(penalty_type), intent(in) :: self
      type(setting_type), intent(in) :: setting
      class(enforcement_type), allocatable, intent(out) :: form

      associate (unused => self)
      end associate
      if (setting%is_stiff() .or. setting%exact_stick .or. setting%elastic_slip) &
         & allocate (perturbed_type :: form)
   end subroutine form_for_newton
end module lopin_enforcement_penalty
