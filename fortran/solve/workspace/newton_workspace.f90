!> What the nonlinear path works with: the contacts, the tangent's system, the last iterations.
module lopin_newton_workspace
   use lopin_kinds, only : wp
   use lopin_csc, only : csc_type
   use lopin_nonlinear_contact, only : nonlinear_contact_type
   use lopin_local_matrix, only : local_matrix_type
   use lopin_newton_system, only : newton_system_type
   use lopin_follower_loading, only : follower_type
   use lopin_contraction, only : contraction_type
   use lopin_state, only : solids_state_type, refused_type
   use lopin_surface_stress, only : surface_stress_type
   implicit none
   private
   public :: newton_workspace_type, add_line, is_nonlinear, iteration_header

   !> What the columns of the lines are.
   character(len=*), parameter :: iteration_header = '  it  equilibrium      contact   '// &
      & 'correction     step   open  stick   slip  gmres tangent'

   !> Resistance to a motion through pseudo-time, see lopin_pseudo_transient.
   type :: damping_type
      logical :: on = .false.
      real(wp) :: rate = 0.0_wp                !! one by the pseudo-time of the step
      type(csc_type) :: metric                 !! (ndof) [force/length]
      real(wp), allocatable :: from(:)         !! (ndof) where the step starts [length]
   end type damping_type

   !> The workspace of Newton's iterations. Many components: scalars that the iterations of an
   !> increment share, and what they report; none outlives the increment but through the state.
   type :: newton_workspace_type
      logical :: in_use = .false.
      logical :: nlgeom = .false.              !! of the present step
      logical :: flows = .false.               !! some material looks back
      logical :: bends = .false.               !! springs have tables
      type(nonlinear_contact_type) :: contact
      type(surface_stress_type) :: surface     !! stresses that laws of friction follow
      type(newton_system_type) :: system
      type(follower_type) :: follower          !! pressures under NLGEOM
      type(csc_type) :: k                      !! (ndof) tangent of the solids, if not linear
      real(wp), allocatable :: internal(:)     !! (ndof) forces of the solids [force]
      type(solids_state_type) :: past          !! what the solids were accepted with, at the
                                               !! temperatures and over the time of the increment
      type(local_matrix_type), allocatable :: turning(:)   !! tangents of rigid bodies of nodes
      real(wp) :: energy = 0.0_wp              !! strain energy of the solids [force*length]
      real(wp) :: dt = 1.0_wp                  !! time increment [time]
      real(wp) :: time = 0.0_wp                !! its end, since the start of the step [time]
      logical :: separated = .false.           !! a tool has left, or a body floats: no guess
      logical :: frictionless = .true.         !! of the present step
      real(wp) :: began = 0.0_wp               !! largest force where Newton began [force]
      real(wp) :: reference = 0.0_wp           !! force that residuals are beside, kept [force]
      logical :: has_solved = .false.          !! some increment, with forces about
      real(wp) :: element_force = 0.0_wp       !! largest of an element on a node, last look [force]
      real(wp) :: correction = 0.0_wp          !! largest of the last step of Newton [length]
      ! what rounding leaves, of the increment
      real(wp) :: noise = 0.0_wp               !! of places [length]
      real(wp), allocatable :: floor(:)        !! (neq) of residuals [force]
      real(wp), allocatable :: row_floor(:)    !! (nmultiplier) of rows [force]
      integer :: most_augmentations = 0
      real(wp) :: augment_until = 0.0_wp       !! relative change of the tractions
      ! of the last increment
      integer :: iterations = 0, augmentations = 0
      integer :: grounded = 0                  !! iterations on soft springs to the ground
      type(contraction_type) :: contraction    !! of Newton
      type(damping_type) :: damping            !! of a motion through pseudo-time
      integer :: attempt = 1                   !! at the increment
      integer :: sized = 0                     !! attempts that were cut before they had failed
      real(wp) :: fit = 1.0_wp                 !! share of the increment that should do
      type(refused_type) :: refused            !! the last attempt, for force that passes in it
      logical :: passes = .false.              !! as much passes in any increment
      real(wp), allocatable :: released(:)   !! (ndof) that the step lets go of at once [force]
      logical :: faded = .false.               !! it was taken away by parts in this increment
      logical :: rests = .false.               !! a part of a run begins: nothing moves but what its
                                               !! mesh leaves out of balance
      logical :: jumped = .false.              !! it was ended by slow motion
      logical :: in_vain = .false.             !! slow motion has come to no rest
      logical :: cycled = .false.              !! Newton came back to the same sets of contact
      real(wp), allocatable :: history(:)      !! residual by iteration, beside the largest force
      integer :: nline = 0
      character(len=100), allocatable :: line(:)   !! what each iteration did, for the log
   end type newton_workspace_type
contains

   !> The bodies are not linear: finite strain, flow, or springs with tables.
   pure logical function is_nonlinear(self)
      type(newton_workspace_type), intent(in) :: self
      is_nonlinear = self%nlgeom .or. self%flows .or. self%bends
   end function is_nonlinear

   !> Keep a line for the log of the increment.
   subroutine add_line(self, text)
      type(newton_workspace_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      character(len=100), allocatable :: more(:)

      if (.not. allocated(self%line)) allocate (self%line(64))
      if (self%nline == size(self%line)) then
         allocate (more(2*self%nline))
         more(:self%nline) = self%line
         call move_alloc(more, self%line)
      end if
      self%nline = self%nline + 1
      self%line(self%nline) = text
   end subroutine add_line
end module lopin_newton_workspace
