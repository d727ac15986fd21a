!> What *FRICTION, *PLASTIC, *CHANGE FRICTION and *MODEL CHANGE become in the model.
program test_build_friction
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_block, only : deck_type
   use lopin_deck, only : read_deck_text
   use lopin_model, only : model_type
   use lopin_build_model, only : new_model
   use lopin_friction, only : friction_type, law_of, regularization_of, automatic_law, has_friction
   use lopin_surface_material, only : pair_materials, slave_yields
   use check, only : test, close_to, is_true, equal_text, finish
   implicit none

   character(len=1), parameter :: nl = achar(10)
   type(model_type) :: model
   type(error_type), allocatable :: error

   call coulomb()
   call laws_of_the_yield_stress()
   call laws_of_the_speed()
   call automatic()
   call changes()
   call yields()
   call yield_of_every_hardening()
   call finish()

contains

   !> Two squares, the upper on the lower, with these cards in the interaction, material and step.
   subroutine build(friction, plastic, in_step)
      character(len=*), intent(in) :: friction           !! lines separated by |
      character(len=*), intent(in), optional :: plastic, in_step
      type(deck_type) :: deck
      type(log_type) :: log
      character(len=:), allocatable :: text
      integer :: i

      text = '*NODE|1, 0., 1.|2, 1., 1.|3, 1., 2.|4, 0., 2.|' &
         & //'5, 0., 0.|6, 1., 0.|7, 1., 1.|8, 0., 1.|' &
         & //'*ELEMENT, TYPE=CPE4, ELSET=UP|1, 1, 2, 3, 4|*ELEMENT, TYPE=CPE4, ELSET=LOW|' &
         & //'2, 5, 6, 7, 8|*SURFACE, NAME=S|UP, S1|*SURFACE, NAME=M|LOW, S3|' &
         & //'*MATERIAL, NAME=HARD|*ELASTIC|210000., 0.3|*MATERIAL, NAME=SOFT|*ELASTIC|7000., 0.3|'
      if (present(plastic)) text = text//plastic//'|'
      text = text//'*SOLID SECTION, ELSET=UP, MATERIAL=SOFT|1.|*SOLID SECTION, ELSET=LOW, ' &
         & //'MATERIAL=HARD|1.|*SURFACE INTERACTION, NAME=I|'//friction//'|' &
         & //'*CONTACT PAIR, INTERACTION=I|S, M|*STEP|*STATIC|0.1, 1.|'
      if (present(in_step)) text = text//in_step//'|'
      text = text//'*END STEP|'
      do i = 1, len(text)
         if (text(i:i) == '|') text(i:i) = nl
      end do
      call read_deck_text(deck, text, 'deck.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      if (allocated(error)) print '(a)', error%text()
      call is_true('no error in '//friction, .not. allocated(error))
   end subroutine build

   function friction_of(card, plastic) result(friction)
      character(len=*), intent(in) :: card
      character(len=*), intent(in), optional :: plastic
      type(friction_type) :: friction

      call build(card, plastic)
      if (.not. allocated(error)) friction = model%interaction(1)%friction
   end function friction_of

   subroutine coulomb()
      type(friction_type) :: law

      call test('Coulomb: mu, the stick slope of CalculiX, the words of stick')
      law = friction_of('*FRICTION|0.3, 1.e4')
      call is_true('law', law%law == law_of%coulomb .and. law%at%line > 0)
      call close_to('data', [law%mu, law%stick_slope], [0.3_wp, 1.0e4_wp], 0.0_wp)
      call is_true('no cap', law%tau_max >= huge(1.0_wp))
      law = friction_of('*FRICTION, TAUMAX=50., ELASTIC SLIP=1.e-3|0.3')
      call close_to('words', [law%tau_max, law%elastic_slip], [50.0_wp, 1.0e-3_wp], 0.0_wp)
      law = friction_of('*FRICTION, SLIP TOLERANCE=0.01|0.3')
      call close_to('tolerance', law%slip_tolerance, 0.01_wp, 0.0_wp)
      law = friction_of('*FRICTION, LAGRANGE|0.3')
      call is_true('exact', law%exact_stick)
      law = friction_of('*FRICTION, REGULARIZATION=NONE|0.3')
      call is_true('also exact', law%exact_stick .and. law%regularization &
         & == regularization_of%linear)
      law = friction_of('*FRICTION, ROUGH')
      call is_true('rough', law%rough .and. has_friction(law))
      law = friction_of('*FRICTION|0.')
      call is_true('mu = 0 is no friction', .not. has_friction(law))
      law = friction_of('*FRICTION')
      call is_true('nor is none given', .not. has_friction(law))
      law = friction_of('*FRICTION, REGULARIZATION=TANH, ELASTIC SLIP=0.5|0.3')
      call is_true('tanh', law%regularization == regularization_of%tanh)
      call close_to('u0', law%elastic_slip, 0.5_wp, 0.0_wp)
   end subroutine coulomb

   subroutine laws_of_the_yield_stress()
      character(len=*), parameter :: plastic = '*PLASTIC|90., 0.|120., 0.1'
      type(friction_type) :: law

      call test('Tresca, Orowan, Cristescu: shear factor and yield stress')
      law = friction_of('*FRICTION, LAW=TRESCA|0.4', plastic)
      call is_true('tresca', law%law == law_of%tresca .and. law%has_m)
      call close_to('m', law%m, 0.4_wp, 0.0_wp)
      call close_to('first row of *PLASTIC', model%material(2)%yield, 90.0_wp, 0.0_wp)
      call is_true('hardens', model%material(2)%hardens .and. .not. model%material(1)%hardens)
      law = friction_of('*FRICTION, LAW=TRESCA, TAUMAX=30.')
      call is_true('TAUMAX alone', law%law == law_of%tresca .and. .not. law%has_m)
      law = friction_of('*FRICTION, LAW=COULOMB-OROWAN|0.1, 0.4', plastic)
      call is_true('orowan', law%law == law_of%orowan)
      call close_to('mu, m', [law%mu, law%m], [0.1_wp, 0.4_wp], 0.0_wp)
      law = friction_of('*FRICTION, LAW=CRITESCU|0.4')
      call is_true('as the lecture spells it', law%law == law_of%cristescu)
      law = friction_of('*FRICTION, LAW=TRESCA, EQUIVALENT=MISES|0.4')
      call is_true('Tresca of the von Mises stress', law%law == law_of%cristescu)
   end subroutine laws_of_the_yield_stress

   subroutine laws_of_the_speed()
      type(friction_type) :: law

      call test('laws of the speed: Norton-Hoff, decay, V0')
      law = friction_of('*FRICTION, LAW=NORTON-HOFF|5., 0.2')
      call is_true('norton', law%law == law_of%norton_hoff)
      call close_to('alpha, q', [law%alpha, law%q], [5.0_wp, 0.2_wp], 0.0_wp)
      law = friction_of('*FRICTION, EXPONENTIAL DECAY|0.3, 0.1, 2.')
      call close_to('static, kinetic, decay', [law%mu_static, law%mu, law%decay], [0.3_wp, 0.1_wp, &
         & 2.0_wp], 0.0_wp)
      law = friction_of('*FRICTION, EXPONENTIAL DECAY|0.3, 0.1, 0.')
      call close_to('without decay it stays static', [law%mu, law%decay], [0.3_wp, 0.0_wp], 0.0_wp)
      law = friction_of('*FRICTION, REGULARIZATION=ARCTAN, V0=0.01|0.3')
      call close_to('V0', law%v0, 0.01_wp, 0.0_wp)
      call is_true('arctan', law%regularization == regularization_of%arctan)
   end subroutine laws_of_the_speed

   subroutine automatic()
      type(friction_type) :: law
      character(len=:), allocatable :: why
      integer :: number

      call test('LAW=AUTO goes with the material of the slave (lecture E, remarks 2 to 6)')
      law = friction_of('*FRICTION, LAW=AUTO|0.1, 0.4, 5., 0.2')
      call is_true('elastic', law%law == law_of%coulomb)
      call close_to('mu', law%mu, 0.1_wp, 0.0_wp)
      law = friction_of('*FRICTION, LAW=AUTO|0.1, 0.4', '*PLASTIC|90.')
      call is_true('perfectly plastic', law%law == law_of%tresca)
      call close_to('m', law%m, 0.4_wp, 0.0_wp)
      law = friction_of('*FRICTION, LAW=AUTO|, 0.4', '*PLASTIC|90., 0.|100., 1.')
      call is_true('hardening', law%law == law_of%cristescu)
      law = friction_of('*FRICTION, LAW=AUTO|0.')
      call is_true('mu = 0', .not. has_friction(law))
      call automatic_law(.true., .true., .true., number, why)
      call is_true('viscoplastic', number == law_of%norton_hoff .and. why == 'viscoplastic')
   end subroutine automatic

   subroutine changes()
      call test('a step changes friction and pairs')
      call build('*FRICTION|0.1', in_step='*CHANGE FRICTION, INTERACTION=I|*FRICTION, ROUGH|' &
         & //'*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE|S, M')
      call is_true('one of each', size(model%step(1)%friction_change) == 1 &
         & .and. size(model%step(1)%pair_change) == 1)
      call is_true('rough', model%step(1)%friction_change(1)%friction%rough &
         & .and. model%step(1)%friction_change(1)%interaction == 1)
      call is_true('removed', model%step(1)%pair_change(1)%pair == 1 &
         & .and. .not. model%step(1)%pair_change(1)%active)
      call close_to('the model keeps its own', model%interaction(1)%friction%mu, 0.1_wp, 0.0_wp)
      call build('*FRICTION|0.1')
      call is_true('none of each', size(model%step(1)%friction_change) == 0 &
         & .and. size(model%step(1)%pair_change) == 0)
   end subroutine changes

   subroutine yields()
      logical :: used(2)
      real(wp) :: yield(8)

      call test('the yield stress behind the slave, at its nodes only')
      call build('*FRICTION, LAW=TRESCA|0.1', '*PLASTIC|90., 0.')
      call pair_materials(model, 1, used)
      call is_true('the slave is soft', used(2) .and. .not. used(1))
      call slave_yields(model, 1, yield)
      call close_to('of the upper square', yield, [90.0_wp, 90.0_wp, 90.0_wp, 90.0_wp, 0.0_wp, &
         & 0.0_wp, 0.0_wp, 0.0_wp], 0.0_wp)
   end subroutine yields

   !> Whatever card says it, also where the solid stays elastic and only friction reads it.
   subroutine yield_of_every_hardening()
      real(wp), parameter :: hollomon = (500.0_wp/7000.0_wp**0.2_wp)**1.25_wp
      character(len=13), parameter :: only(2) = [character(len=13) :: '', 'ONLY=FRICTION']
      character(len=:), allocatable :: word
      integer :: i

      call test('the yield stress is that of the curve before anything is strained')
      do i = 1, 2
         word = '*PLASTIC'
         if (len_trim(only(i)) > 0) word = word//', '//trim(only(i))
         call yield_is(word//'|90., 0.|120., 0.1', 90.0_wp)
         call yield_is(word//'|90., 0., 20.|120., 0.1, 20.|60., 0., 120.', 90.0_wp)
         call yield_is(word//', HARDENING=SWIFT|500., 0.01, 0.2', 500.0_wp*0.01_wp**0.2_wp)
         call yield_is(word//', HARDENING=VOCE|300., 90., 5.', 90.0_wp)
         call yield_is(word//', HARDENING=LINEAR|90., 7.', 90.0_wp)
         call yield_is(word//', HARDENING=HOLLOMON|500., 0.2, 80.', 80.0_wp)
         call yield_is(word//', HARDENING=HOLLOMON|500., 0.2', hollomon)
         call yield_is(word//', HARDENING=KINEMATIC|90., 0.|120., 0.1', 90.0_wp)
         call yield_is(word//', HARDENING=COMBINED, DATA TYPE=PARAMETERS|90., 500., 5.', 90.0_wp)
      end do
      call yield_is('*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS|90., 500., 5.|' &
         & //'*CYCLIC HARDENING|75., 0.|85., 0.1', 75.0_wp)
   end subroutine yield_of_every_hardening

   subroutine yield_is(plastic, expected)
      character(len=*), intent(in) :: plastic
      real(wp), intent(in) :: expected     !! [stress]

      call build('*FRICTION, LAW=TRESCA|0.1', plastic)
      call close_to(plastic, model%material(2)%yield/expected, 1.0_wp, 1.0e-12_wp)
   end subroutine yield_is
end program test_build_friction
