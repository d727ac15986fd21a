!> Augmented Lagrangian (lecture J.4, Uzawa's update): the penalty system with a frozen multiplier,
!> which takes over the spring's force after each solve until nothing moves.
module lopin_enforcement_augmented
   use lopin_kinds, only : wp
   use lopin_enforcement, only : enforcement_type, setting_type
   use lopin_enforcement_lagrange, only : lagrange_type
   implicit none
   private
   public :: augmented_type, mixed_type

   !> Slopes above this, in moduli over a facet, leave Newton no way between open and closed. The
   !> limit of the augmentations does not depend on them: it is taken at once.
   real(wp), parameter :: stiffest = 1000.0_wp

   type, extends(enforcement_type) :: augmented_type
   contains
      procedure :: word
      procedure :: solves_for_multiplier
      procedure :: updates
      procedure :: update
      procedure :: form_for_newton
   end type augmented_type

   !> The same with the force as an unknown: from the frozen multiplier on, penetration grows with
   !> the force, and stiff springs do nothing to Newton.
   type, extends(augmented_type) :: mixed_type
   contains
      procedure :: solves_for_multiplier => mixed_solves
      procedure :: penetration => mixed_penetration
   end type mixed_type

contains

   function word(self)
      class(augmented_type), intent(in) :: self
      character(len=:), allocatable :: word
      associate (unused => self)
         word = 'augmented'
      end associate
   end function word

   pure logical function solves_for_multiplier(self)
      class(augmented_type), intent(in) :: self
      associate (unused => self)
         solves_for_multiplier = .false.
      end associate
   end function solves_for_multiplier

   pure logical function updates(self)
      class(augmented_type), intent(in) :: self
      associate (unused => self)
         updates = .true.
      end associate
   end function updates

   elemental subroutine update(self, force, multiplier, change)
      class(augmented_type), intent(in) :: self
      real(wp), intent(in) :: force
      real(wp), intent(inout) :: multiplier
      real(wp), intent(out) :: change
      associate (unused => self)
         change = force - multiplier
         multiplier = force
      end associate
   end subroutine update

   !> What gives way along the face as the deck says is no error that augmentation may mend: there,
   !> and by very stiff springs, the limit is solved for. By stiff springs along a face that rubs,
   !> the mixed form.
   subroutine form_for_newton(self, setting, form)
      class(augmented_type), intent(in) :: self
      type(setting_type), intent(in) :: setting
      class(enforcement_type), allocatable, intent(out) :: form

      associate (unused => self)
      end associate
      if (setting%stiffness > stiffest .or. setting%given_slip) then
         allocate (lagrange_type :: form)
      else if (setting%is_stiff() .and. setting%rubs) then
         allocate (mixed_type :: form)
      end if
   end subroutine form_for_newton

   pure logical function mixed_solves(self)
      class(mixed_type), intent(in) :: self
      associate (unused => self)
         mixed_solves = .true.
      end associate
   end function mixed_solves

   elemental real(wp) function mixed_penetration(self, force, alpha) result(penetration)
      class(mixed_type), intent(in) :: self
      real(wp), intent(in) :: force, alpha
      associate (unused => self)
         penetration = force/alpha
      end associate
   end function mixed_penetration
end module lopin_enforcement_augmented
