!> Contact of slave nodes with surfaces and tools on the present shape (helper POINTS fills it).
module lopin_finite_contact
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   implicit none
   private
   public :: local_matrix_type, finite_contact_type, new_finite_contact, start_increment
   public :: evaluate, augment, accept, reject

   !> The exact tangent of one contact point.
   type :: local_matrix_type
      integer, allocatable :: dof(:)           !! physical dofs, then ndof + multiplier row
      real(wp), allocatable :: k(:, :)         !! d(-force, row)/d(u, multiplier)
      integer :: nu = 0                        !! entries that are displacements
      real(wp), allocatable :: spring(:, :)    !! (nu, nu) positive semidefinite part, for a factor
   end type local_matrix_type

   type :: finite_contact_type
      integer :: n = 0                         !! points
      integer :: nmultiplier = 0               !! rows: ndim per point whose method solves for it
      integer :: nlocal = 0
      real(wp), allocatable :: force(:)        !! (ndof) of the contacts on the dofs [force]
      real(wp), allocatable :: row(:)          !! (nmultiplier) residuals [length]
      integer, allocatable :: point_of_row(:)  !! (nmultiplier)
      type(local_matrix_type), allocatable :: local(:)
      ! of each point
      integer, allocatable :: pair(:), node(:)
      integer, allocatable :: facet(:)         !! 0: no master opposite
      integer, allocatable :: status(:)        !! 0 open, 1 stick or closed, 2 slip
      logical, allocatable :: bilateral(:)
      real(wp), allocatable :: weight(:)       !! tributary area [length^2]
      real(wp), allocatable :: size(:)         !! of the slave's facets [length]
      real(wp), allocatable :: c(:), ct(:)     !! normal and tangential stiffness [stress/length]
      real(wp), allocatable :: gap(:), pressure(:)
      real(wp), allocatable :: traction(:, :)  !! (3, n) on the slave [stress]
      real(wp), allocatable :: normal(:, :)    !! (3, n)
      real(wp), allocatable :: slip(:, :)      !! (3, n) since the start of the run, accumulated
      real(wp), allocatable :: xi(:, :)        !! (2, n)
      real(wp), allocatable :: slip_path(:)    !! (n) its length
      real(wp), allocatable :: friction_work(:) !! (n) dissipated per area [stress*length]
      real(wp) :: soft_error = 0.0_wp          !! estimated pressure error of penalties, relative
   end type finite_contact_type

contains

   subroutine new_finite_contact(self, model, dofs, log, error)
      type(finite_contact_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error

      associate (unused => log)
      end associate
      allocate (self%force(dofs%n), source=0.0_wp)
      allocate (self%row(0), self%point_of_row(0), self%local(0), self%pair(0), self%node(0))
      allocate (self%facet(0), self%status(0), self%bilateral(0), self%weight(0), self%size(0))
      allocate (self%c(0), self%ct(0), self%gap(0), self%pressure(0), self%traction(3, 0))
      allocate (self%normal(3, 0), self%slip(3, 0), self%xi(2, 0), self%slip_path(0))
      allocate (self%friction_work(0))
      if (size(model%pair) > 0) call raise(error, error_code%deck, 'E0108', &
         & 'contact on the finite path is not in this version', model%pair(1)%at)
   end subroutine new_finite_contact

   !> Search from the accepted state and set the anchors of friction.
   subroutine start_increment(self, model, u, dt, error)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) accepted displacements
      real(wp), intent(in) :: dt               !! [time]
      type(error_type), allocatable, intent(out) :: error

      associate (unused => model, also => u, more => dt)
      end associate
      if (allocated(error)) self%nlocal = 0
   end subroutine start_increment

   !> Project at x = X + u, apply the laws: force, row and, if asked, the local matrices.
   subroutine evaluate(self, model, u, multiplier, with_tangent, error)
      type(finite_contact_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof)
      real(wp), intent(in) :: multiplier(:)    !! (nmultiplier) tractions, global axes [stress]
      logical, intent(in) :: with_tangent
      type(error_type), allocatable, intent(out) :: error

      associate (unused => model, also => u, more => multiplier, last => with_tangent)
      end associate
      self%force = 0.0_wp
      if (allocated(error)) self%nlocal = 0
   end subroutine evaluate

   !> Augmented Lagrangian: take the present tractions for the next solve.
   subroutine augment(self, change)
      type(finite_contact_type), intent(inout) :: self
      real(wp), intent(out) :: change          !! relative, of the tractions

      self%nlocal = 0
      change = 0.0_wp
   end subroutine augment

   !> Commit the history of the trial state.
   subroutine accept(self, u, multiplier)
      type(finite_contact_type), intent(inout) :: self
      real(wp), intent(in) :: u(:), multiplier(:)

      associate (unused => u, also => multiplier)
      end associate
      self%nlocal = 0
   end subroutine accept

   !> Back to the history that was committed last; the same bits.
   subroutine reject(self)
      type(finite_contact_type), intent(inout) :: self
      self%nlocal = 0
   end subroutine reject
end module lopin_finite_contact
